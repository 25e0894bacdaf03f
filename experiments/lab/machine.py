"""The machine that a reproduction ran on, as the page and docs/results.md tell it."""

import os
import platform
import time

from lab.runs import Machine


def describe_machine(machine: Machine) -> dict[str, str]:
    """What a reader needs to judge the times."""
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return {
        "processor": machine.processor,
        "cores": str(os.cpu_count()),
        "memory": f"{memory:.0f} GiB",
        "system": f"{platform.system()} {platform.release().split('-')[0]}",
        "Vulkan device": machine.vulkan or "none",
        "program": machine.version,
        "date": time.strftime("%Y-%m-%d", time.gmtime()),
    }
