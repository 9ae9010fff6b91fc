"""The exceptions that mean something to the caller. A module of their own: the command needs them before anything else."""


class UrdfcheckError(Exception):
    """urdfcheck or its configuration failed: the command ends with exit code 2 and this text."""


class FactUnavailableError(Exception):
    """A fact cannot be had for this model; the text says why. The engine lists the check as skipped."""


class ModelTimeout(BaseException):
    """The time of the model that is being checked is over. No Exception: whoever handles those must not go on."""
