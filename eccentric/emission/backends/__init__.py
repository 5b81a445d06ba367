"""What a Program is printed as: a folder for each target, with the same names of files in each.

They share `expression` (an expression in a language), `pairs` (pairs of doubles) and `text` (free text).
"""
