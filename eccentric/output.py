"""`show` under the name that scripts import it by."""
