"""The C99 header and source of a Program."""
