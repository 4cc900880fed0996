"""Stated against observed frequency, over the records of sealed challenges that have them.

python3 benches/gap/reliability.py

Reads the tables "said | mean | came true" of the records: each row has the mean of n stated probabilities and how many of the n
came true. Prints them together, and of each half (challenge 10; 14 and 15) the weight of the prior in a pool of prior and posterior
that fits best, with the log score of the other half without and with it (smaller is better). A row counts as if all of it had been
said with its mean.
"""

import math
import pathlib
import re

HALVES = [["10"], ["14", "15"]]
# Of 24 statements a case has, the priors of effects (0.5 for one, twice 0.15 for two), of no gap (0.2) and of something unknown
# (0.15) share this.
PRIOR = (0.5 + 2 * 0.15 + 0.2 + 0.15) / 24
ROW = re.compile(r"\| (\d\.\d)–(\d\.\d) \| ([\d.]+) \| \d+ % \((\d+)/(\d+),")


def rows(challenge):
    text = (pathlib.Path(__file__).parent / challenge / "README.md").read_text()
    return [(m[1] + "–" + m[2], float(m[3]), int(m[4]), int(m[5])) for m in ROW.finditer(text)]


def wilson(hits, of, z=1.96):
    share, spread = hits / of, z * z / of
    half = z * math.sqrt(share * (1 - share) / of + spread / (4 * of))
    return [(share + spread / 2 + sign * half) / (1 + spread) for sign in (-1, 1)]


def log_score(challenges, weight):
    total = 0.0
    for challenge in challenges:
        for _, said, hits, of in rows(challenge):
            reported = said + weight * (PRIOR - said)
            total -= hits * math.log(reported) + (of - hits) * math.log(1 - reported)
    return total


def main():
    together = {}
    for challenge in sum(HALVES, []):
        for said, mean, hits, of in rows(challenge):
            before = together.get(said, (0.0, 0, 0))
            together[said] = (before[0] + mean * of, before[1] + hits, before[2] + of)
    print("| said | mean | came true | 95 % interval |\n| --- | --- | --- | --- |")
    for said, (total, hits, of) in sorted(together.items()):
        low, high = wilson(hits, of)
        print(f"| {said} | {total / of:.3f} | {hits} of {of}, {100 * hits / of:.1f} % | {100 * low:.1f} to {100 * high:.1f} % |")
    print("\n| fitted to | weight | log score of the others without it | with it |\n| --- | --- | --- | --- |")
    for half, others in (HALVES, HALVES[::-1]):
        best = min((k / 1000 for k in range(301)), key=lambda weight: log_score(half, weight))
        print(f"| {', '.join(half)} | {best:.3f} | {log_score(others, 0.0):.1f} | {log_score(others, best):.1f} |")


if __name__ == "__main__":
    main()
