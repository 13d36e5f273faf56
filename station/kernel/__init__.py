"""The arithmetic of the control cycle: one source that runs interpreted or compiled.

Every module with a `.pxd` file beside it is plain Python over doubles in contiguous
memory. Interpreted it runs as it stands. Cython compiles the same file with the C types
of the `.pxd`, to the same results bit for bit. Which of the two runs is settled here,
before the first of these modules is imported: `STATUS` says which, and why.
"""

from station.kernel.built import KernelStatus, find_kernel, load_kernel

__all__ = ["STATUS", "KernelStatus"]

STATUS = load_kernel(find_kernel(), __path__)
"""Which kernel this process runs."""
