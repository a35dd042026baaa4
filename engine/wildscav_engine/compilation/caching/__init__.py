"""The cache of compiled code: its folders, locks and digests of sources."""
