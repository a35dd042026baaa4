"""An example of a package that extends Wildscav: ``docs/extending.md``."""
