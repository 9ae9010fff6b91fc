"""What a xacro is expanded with that its file does not say: arguments of launch files, and variables of a ROS shell."""
