#!/bin/bash
# One picture on many machines: a SLURM array renders shares of the samples, a last job joins them.
#
#   sbatch docs/examples/slurm-array.sh plant.gsz plant.exr
#
# Any other way to run commands on many machines will do; what matters is the list of commands.
#SBATCH --job-name=sunshine
#SBATCH --array=0-15
#SBATCH --cpus-per-task=16
#SBATCH --mem=8G
#SBATCH --time=04:00:00
# Five minutes before the time is over SLURM sends a signal: Sunshine saves the film and ends.
#SBATCH --signal=TERM@300
#SBATCH --requeue
set -euo pipefail
scene=$1
picture=$2

samples=4096 # of the whole picture; a multiple of 64 times the number of shares divides evenly
shares=$((SLURM_ARRAY_TASK_MAX + 1))
share=$((samples / shares))
first=$((SLURM_ARRAY_TASK_ID * share))
last=$((first + share))
film=$picture.$first-$last.film

# The settings must be the same in all shares. With --resume a job that was stopped goes on where it was.
code=0
srun sunshine render "$scene" --size 3840x2160 --samples $samples --sample-range $first..$last \
  --device cpu --threads "$SLURM_CPUS_PER_TASK" --checkpoint "$film" --resume "$film" || code=$?
if [ $code = 143 ]; then
  scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
  exit 0
fi
[ $code = 0 ] || exit $code

# Whoever finishes last makes the picture; a merge of an incomplete picture ends with an error and writes nothing.
sunshine merge "$picture".*.film -o "$picture" || echo "not all shares are finished yet"
