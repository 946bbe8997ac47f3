"""The commands of `pneurod`, by what they work on; `pipeline.cli` puts them together."""
