"""Agents that kill the processes around them, once."""

KILLS_ITS_FIRST_WORKER = """
    def act(self, observation):
        if observation.step == 7 and not os.path.exists("was_here"):
            open("was_here", "w").close()
            os.kill(os.getppid(), signal.SIGKILL)
            time.sleep(600)
        return Action(walk_speed=5.0)
"""
KILLS_RAYS_PROCESS = KILLS_ITS_FIRST_WORKER.replace(
    "os.getppid()", 'int(open(f"/proc/{os.getppid()}/stat").read().rpartition(")")[2].split()[1])'
)
