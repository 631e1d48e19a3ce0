"""The flat form of a chain and the compiled code that runs on it.

`nao_kin.kernels.joint_path` needs numpy only; the other modules import numba, so import them where they are used.
"""
