"""The client for plain Python, generated from `_async` by tools/generate_client.py."""
