#!/bin/sh
#SBATCH --job-name=sweep
#SBATCH --array=1-16
#SBATCH --cpus-per-task=4
# Runs one part of a study: sbatch slurm.sh STUDY.toml
set -eu
softlimb sweep "$1" --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" --threads "$SLURM_CPUS_PER_TASK" --out "part-$SLURM_ARRAY_TASK_ID.csv"
