"""Readers: a log file in, named columns out, nothing converted and nothing dropped; no physics."""
