"""What is no input and no parameters of an emitted module."""

import numpy as np

NO_NUMBERS = [
    (1j, "complex"),
    (np.array([1.0 + 0j]), "ndarray of complex128"),
    ("1", "str"),
    (np.array(["1"]), "ndarray of str"),
    (b"1", "bytes"),
    (None, "NoneType"),
    ([1.0, None], "list of object"),
    (("1", "2"), "tuple of str"),
    (np.array([1.0], dtype=object), "ndarray of object"),
    ({}, "dict"),
    (np.array(["2020-01-01"], dtype="datetime64[D]"), "ndarray of datetime64"),
    (np.timedelta64(1, "s"), "timedelta64"),
]
"""Each with the words for what came: the type that the caller gave, and of what it is made."""
NO_PARAMETERS = [{"mu": 0.2}, [0.2], np.array([0.2]), (), 0, 0.2, "", "mu", object()]
