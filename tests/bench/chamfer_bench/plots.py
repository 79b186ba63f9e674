"""The figures as pictures, where matplotlib is installed (Debian: python3-matplotlib); elsewhere a line says what is missing."""


def _pyplot():
    try:
        import matplotlib
    except ImportError:
        print("no plot: matplotlib is not installed for this Python (Debian: python3-matplotlib); the JSON has all figures")
        return None
    matplotlib.use("svg")
    from matplotlib import pyplot
    return pyplot


def _save(pyplot, figure, path):
    figure.savefig(path)
    pyplot.close(figure)
    print(f"plot: {path}")


def table(path, rows):
    """Bars: time and memory of each rounding over none, scene by scene."""
    pyplot = _pyplot()
    if not pyplot or not rows:
        return
    scenes = list(dict.fromkeys(r["scene"] for r in rows))
    roundings = list(dict.fromkeys(r["rounding"] for r in rows))
    figure, panels = pyplot.subplots(2, 1, figsize=(1.5 + 1.9 * len(scenes), 7), constrained_layout=True)
    for panel, key, title in ((panels[0], "time_ratio", "render time / none"), (panels[1], "memory_ratio", "peak memory / none")):
        for k, rounding in enumerate(roundings):
            values = {r["scene"]: r[key] for r in rows if r["rounding"] == rounding}
            at = [i + (k - (len(roundings) - 1) / 2) * 0.8 / len(roundings) for i, s in enumerate(scenes) if s in values]
            panel.bar(at, [values[s] for s in scenes if s in values], 0.8 / len(roundings), label=rounding)
        panel.set_xticks(range(len(scenes)), scenes)
        panel.axhline(1, color="black", linewidth=0.8)
        panel.set_ylabel(title)
    panels[0].legend(ncols=len(roundings), fontsize="small", loc="upper center", bbox_to_anchor=(0.5, 1.2))
    _save(pyplot, figure, path)


def flight(path, points, roundings):
    """Curves: cost in percent over the share of affected rays."""
    pyplot = _pyplot()
    if not pyplot or not points:
        return
    figure, panel = pyplot.subplots(figsize=(7, 4.5), constrained_layout=True)
    for rounding in roundings:
        pairs = sorted((100 * p["rounded_share"], 100 * (p["time_ratio"][rounding] - 1)) for p in points)
        panel.plot(*zip(*pairs), marker="o", label=rounding)
    panel.axhline(0, color="black", linewidth=0.8)
    panel.set_xlabel("camera and bounce rays on roundings, %")
    panel.set_ylabel("render time over none, %")
    panel.legend()
    _save(pyplot, figure, path)
