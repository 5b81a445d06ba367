"""`read_arm` under the name that scripts have imported it by."""
