"""The models, launch files and packages of a run: variants of one file, parts of others, and what could not be checked."""
