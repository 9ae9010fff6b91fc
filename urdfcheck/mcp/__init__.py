"""urdfcheck for language models: a few tools over the Model Context Protocol."""
