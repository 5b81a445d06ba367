"""The loop: fit, search, extend, refit, score; and the result in words and JSON."""
