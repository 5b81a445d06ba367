"""What is no input and no parameters of an emitted module."""

import numpy as np

NO_NUMBERS = [
    1j,
    np.array([1.0 + 0j]),
    "1",
    np.array(["1"]),
    b"1",
    None,
    [1.0, None],
    np.array([1.0], dtype=object),
    {},
    np.array(["2020-01-01"], dtype="datetime64[D]"),
    np.timedelta64(1, "s"),
]
NO_PARAMETERS = [{"mu": 0.2}, [0.2], np.array([0.2]), (), 0, 0.2, "", "mu", object()]
