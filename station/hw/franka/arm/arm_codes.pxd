# Constants alone: a compiled module imports no other module that is not compiled.
