"""One module per rule page, with the page's stem as its name."""
