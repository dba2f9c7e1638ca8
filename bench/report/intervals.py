"""What a count or a few repeats tell, by scipy: intervals, and which of many rows differ."""

import numpy
from scipy.stats import binom, binomtest, fisher_exact

LEVEL = 0.95


def proportion(count, trials):
    """Clopper and Pearson's interval of the probability behind a count, at 95%."""
    with numpy.errstate(divide="ignore"):  # of the p-value, which nobody asks for
        interval = binomtest(count, trials).proportion_ci(LEVEL, method="exact")
    return interval.low, interval.high


def median_coverage(repeats):
    """How surely least and most of so many repeats hold the median between them: the sign test's interval."""
    return 1.0 - 2.0 * binom.cdf(0, repeats, 0.5)


def holm(p_values):
    """Holm's adjusted p-values: those below 0.05 hold together with an error of 5%."""
    adjusted, largest = [0.0] * len(p_values), 0.0
    for rank, i in enumerate(sorted(range(len(p_values)), key=lambda i: p_values[i])):
        largest = max(largest, min(1.0, (len(p_values) - rank) * p_values[i]))
        adjusted[i] = largest
    return adjusted


def as_few(counts):
    """Which of the (count, trials) cannot be told from the least rate among them: Fisher's exact test, Holm."""
    least = min(counts, key=lambda pair: pair[0] / pair[1])
    p_values = [fisher_exact([[k, n - k], [least[0], least[1] - least[0]]])[1] for k, n in counts]
    return [p > 1.0 - LEVEL for p in holm(p_values)]
