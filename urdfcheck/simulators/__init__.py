"""The engines that load robot models, one module each, all with the same names.

``INSTALL`` says how to install the engine, ``LIBRARIES`` names its Python modules, ``get_version()`` returns the installed
version (None: not installed), and ``load(robot, path)`` returns the model as the engine loaded it from a file; any exception is a
rejection. Engines run native code on an untrusted file and may crash: see :mod:`urdfcheck.simulators.processes`.
"""
