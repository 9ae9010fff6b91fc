"""The programs that read robot models, each loading one for real: a module for each, with the same names.

``INSTALL`` is how to get it, ``LIBRARIES`` what it imports, ``version()`` what is installed (None: nothing), and
``load(robot, path)`` what it makes of the model in a file; whatever it raises is its refusal. They run native code on a
stranger's file and may end the process that they are in: see :mod:`urdfcheck.simulators.processes`.
"""
