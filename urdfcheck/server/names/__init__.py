"""Names in an editor: which places have one name, and what it takes to give them another."""
