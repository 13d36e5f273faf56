"""The station as its API sees it."""
