from setuptools import Extension, setup


def extension(name: str) -> Extension:
    """Describe a module in C; without a compiler its plain form runs, slower and to the same result."""
    return Extension(
        f"treestroke.core.{name}",
        [f"backend/treestroke/core/{name.replace('.', '/')}.c"],
        # No fused multiply-add: the same photo must give the same bytes on every processor. Nobody reads errno
        # after a square root: without it, roots of several numbers are taken at once.
        extra_compile_args=["-O3", "-ffp-contract=off", "-fno-math-errno"],
        optional=True,
    )


setup(ext_modules=[extension("grow._engine"), extension("leaf._covering")])
