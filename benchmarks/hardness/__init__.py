"""How hard the command is to break: runs that kill it, starve it, repeat it and feed it damage.

    python -m benchmarks.hardness           (20 minutes; --help says how to make it shorter or longer)

trial      one command to run, what it has to leave, and what is wrong if it does not
kills      a run that a signal ends at a random time, and the run after it
disk_full  a run that finds no room for its files
pairs      two runs at once in one folder
soak       many estimates in one process: memory, open files, threads
fuzz       the tests of tests/fuzz, for as long as one likes
table      the results as benchmarks/hardness.json and as the table of docs/RELIABILITY.md
"""
