"""What a project does with its robot, as its manifests, launch files and scripts show."""
