"""Recordings of measuring systems: channels with clocks of their own, each format by its library.

One reader a file: ROS 2 bags, MCAP, MDF, TDMS, ULog. In: a path. Out: a `Read` on one clock.
May import: the rest of `logs`, but `log` and `batches`, which call these readers.
"""
