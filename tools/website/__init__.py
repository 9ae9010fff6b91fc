"""The documentation site as a folder of Markdown pages, made from docs/, rules/, the docstrings and the schemas."""
