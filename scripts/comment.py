#!/usr/bin/env python3
"""Writes a comparison into a pull request: into the comment of ours that is there, or else into a new one.

    scripts/comment.py COMPARISON.md EXIT_CODE PULL_REQUEST

The action .github/actions/compare calls it; it needs `gh`, GH_TOKEN and GITHUB_REPOSITORY. A comment that cannot be written is
a warning, since the verdict does not depend on it: a pull request from a fork has a token that may only read.
"""
import json
import os
import subprocess
import sys
from pathlib import Path

MARKER = "<!-- penumbra compare -->"  # which comment is ours: the workflow's user may write others
MOST_BYTES = 65536  # that GitHub takes; it counts characters, which are no more
CUT = "\n\n*Cut here: a comment holds no more. All of it is in the job's artifact, `comparison.md`.*\n"
NOTHING = ("### penumbra: nothing was compared\n\nExit code {}: a suite could not be measured, or the input was wrong; "
           "the log of the job says why.\n")


def body_of(markdown, code):
    """What the comment says, no longer than GitHub takes. A table is cut between rows, and a fold that is open is closed."""
    text = f"{MARKER}\n{markdown if markdown.strip() else NOTHING.format(code)}"
    if len(text.encode()) <= MOST_BYTES:
        return text
    room = MOST_BYTES - len("\n\n</details>\n".encode()) - len(CUT.encode())
    kept = text.encode()[:room].decode(errors="ignore")
    kept = kept[:kept.rfind("\n")] if "\n" in kept[len(MARKER) + 1:] else kept
    return kept + "\n\n</details>\n" * (kept.count("<details>") > kept.count("</details>")) + CUT


def gh(*words, text=None):
    return subprocess.run(["gh", "api", *words], input=text, capture_output=True, text=True, check=True).stdout


def comment(body, repository, pull_request):
    issues = f"repos/{repository}/issues"
    ours = gh("--paginate", f"{issues}/{pull_request}/comments?per_page=100", "--jq",
              f'.[] | select(.user.login == "github-actions[bot]" and (.body // "" | startswith("{MARKER}"))) | .id').split()
    method, where = ("PATCH", f"{issues}/comments/{ours[-1]}") if ours else ("POST", f"{issues}/{pull_request}/comments")
    gh("--method", method, where, "--input", "-", text=json.dumps({"body": body}))


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    path, code, pull_request = Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    markdown = path.read_text(encoding="utf-8", errors="replace") if path.is_file() else ""
    try:
        comment(body_of(markdown, code), os.environ["GITHUB_REPOSITORY"], pull_request)
    except (OSError, KeyError, subprocess.CalledProcessError) as error:
        why = " ".join(f"{error} {getattr(error, 'stderr', '') or ''}".split()).replace("%", "%25")
        print("::warning title=penumbra::The comparison could not be written to the pull request; it is in the summary and "
              f"the artifact of the job. {why}")


if __name__ == "__main__":
    main()
