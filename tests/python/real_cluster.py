"""The programs of the build as processes, with keys of their own."""

import pathlib
import subprocess
import tempfile

import tessera
from ports import free_port


class RealCluster:
    def __init__(self, programs, *master_options):
        self.programs = programs
        self._folder = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self._folder.name)
        self.keys = self.folder / "keys"
        self.run("tessera", "keys", self.keys)
        self.port = free_port()
        self.endpoint = f"tcp://127.0.0.1:{self.port}"
        self._log = open(self.folder / "log", "w+", encoding="utf-8")
        self._children = []
        self.master_options = ("--listen", self.endpoint, "--heartbeat", "0.25", *master_options)
        self.master = self.start("tessera-master", *self.master_options)

    def run(self, program, *arguments):
        subprocess.run([self.programs / program, *arguments], check=True, stdout=subprocess.DEVNULL)

    def start(self, program, *arguments):
        child = subprocess.Popen([self.programs / program, "--keys", self.keys, *arguments], stdout=self._log,
                                 stderr=self._log)
        self._children.append(child)
        return child

    def kill_master_and_start_another(self):
        self.master.kill()
        self.master.wait(60)
        self.master = self.start("tessera-master", *self.master_options)

    def connect(self, **more):
        return tessera.connect(self.endpoint, **{"keys": self.keys, **more})

    def close(self):
        for child in reversed(self._children):
            child.terminate()
            child.wait(60)
        self._log.close()
        self._folder.cleanup()
