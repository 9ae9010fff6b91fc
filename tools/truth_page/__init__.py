"""The page ``docs/how-true-is-it.md``, made from the data of the benchmarks."""
