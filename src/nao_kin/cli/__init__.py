"""The command line, `nao-kin`: one module a command, each importing what it needs only when it runs."""

from nao_kin.cli.app import main

__all__ = ["main"]
