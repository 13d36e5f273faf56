"""Check a robot's side of the Franka Control Interface, and print a matrix of results.

```sh
station fci check 127.0.0.1                 # reads, and moves nothing
station fci check 127.0.0.1 --move          # every mode, every error, recoveries
pytest -p station.testing.fci_conformance.plugin --fci 127.0.0.1 \
    --pyargs station.testing.fci_conformance
```

The endpoint may be this project's server, another simulator or a real arm. The checks
use only its answers to a client of their own (`dialog`).
"""
