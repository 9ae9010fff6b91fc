"""From a path to located XML: every element and attribute knows where it was typed."""
