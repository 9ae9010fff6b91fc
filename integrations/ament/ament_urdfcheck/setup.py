"""The package ament_urdfcheck, as colcon builds it."""

from setuptools import setup

NAME = "ament_urdfcheck"

setup(
    name=NAME,
    version="0.2.0",
    packages=[NAME],
    data_files=[
        (f"share/{NAME}", ["package.xml"]),
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="The urdfcheck maintainers",
    maintainer_email="nobody@example.org",
    description="Checks robot models with urdfcheck, and writes xunit results",
    license="Apache-2.0",
    entry_points={"console_scripts": [f"{NAME} = {NAME}.main:main"]},
)
