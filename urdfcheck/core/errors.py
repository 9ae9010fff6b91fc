"""The exceptions that callers handle. A separate module, because the command needs them before anything else."""


class UrdfcheckError(Exception):
    """urdfcheck or its configuration failed: the command ends with exit code 2 and this text."""


class ModelNotCheckedError(UrdfcheckError):
    """A command needs a model of which nothing is known; the text says why."""


class FactUnavailableError(Exception):
    """A fact is not available for this model; the text says why. The check is listed as skipped."""


class ModelTimeout(BaseException):
    """The model exceeds its time limit. Derives from BaseException so that ``except Exception`` cannot swallow it."""
