"""Whether the record can be trusted: clipped, frozen and missing data, and what contradicts the rig."""
