from setuptools import Extension, setup

setup(
    ext_modules=[
        Extension(
            "treestroke.core.grow._engine",
            ["backend/treestroke/core/grow/_engine.c"],
            # No fused multiply-add: the same photo must give the same bytes on every processor. Nobody reads errno
            # after a square root: without it, roots of several numbers are taken at once.
            extra_compile_args=["-O3", "-ffp-contract=off", "-fno-math-errno"],
            # Without a compiler growth runs in numpy, slower and to the same result.
            optional=True,
        )
    ]
)
