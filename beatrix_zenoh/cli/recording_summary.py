"""The summary at the end of `beatrix record`."""

from __future__ import annotations

from collections.abc import Mapping

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.output import FAILED, exit_code, note, print_json, say
from beatrix_zenoh.recording.file_output import FileOutput
from beatrix_zenoh.recording.losses import CONTESTED, PICTURES, Count, Stream, findings, total
from beatrix_zenoh.recording.recorder import Recorder


def summarise(recorder: Recorder, output: FileOutput, lasted_s: float, *, as_json: bool) -> int:
    """Print a summary of the recording, and return the exit code."""
    robots = [f"{name} ({side})" for name, side in recorder.robots]
    good, counts = bool(robots) and not output.full, recorder.counts
    whole = total(counts)
    if as_json:
        print_json({
            "result": good,
            "files": [str(path) for path in output.files],
            "robots": robots,
            "seconds": round(lasted_s, 2),
            "positions": recorder.samples,
            **outcome(whole),
            "streams": [
                {"robot": name, "side": side, "stream": what, "published": one.published, **outcome(one)}
                for ((name, side), what), one in counts.items()
            ],
            "bytes": output.bytes,
        })  # fmt: skip
    elif robots:
        files = ", ".join(map(str, output.files))
        for (_, cause), text in findings(counts).items():
            if cause != CONTESTED:  # the line below says it
                note(text)
        say(
            f"{files}: {lasted_s:.1f} s of {', '.join(robots)}, {recorder.samples} positions, {missing(counts)}, "
            f"{output.bytes / 1e6:.1f} MB. To view it: beatrix view {output.files[-1]}"
        )
    else:
        note("No robot was online: the recording is empty. `beatrix ls` shows the robots online.")
    if not robots:
        return exit_code(Reason.NO_ANSWER)
    return 0 if good else FAILED


def outcome(one: Count) -> dict[str, int | None]:
    """Return what became of publications, as data; None: unknown."""
    lost = None if one.contested else one.lost
    return {"lost": lost, "dropped": one.unwritten, "late": one.late, "repeated": one.repeated}


def missing(counts: Mapping[Stream, Count]) -> str:
    """Return how many publications the recording lacks, in words; pictures apart, because they are often left out."""
    pictures = total({stream: one for stream, one in counts.items() if stream[1].startswith(PICTURES)})
    others = total({stream: one for stream, one in counts.items() if not stream[1].startswith(PICTURES)})
    words = {
        "lost on the network": others.lost,
        "dropped": others.unwritten,
        "pictures lost": pictures.lost + pictures.unwritten,
    }
    known = [f"{number} {what}" for what, number in words.items() if number]
    contested = sorted({f"{name} ({side})" for ((name, side), _), one in counts.items() if one.contested})
    if contested:
        known.append(f"losses unknown, because two programs publish the positions of {', '.join(contested)}")
    return ", ".join(known) or "nothing dropped"
