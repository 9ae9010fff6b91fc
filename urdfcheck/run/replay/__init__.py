"""What an earlier run found is reported again while everything that it depends on is as it was."""
