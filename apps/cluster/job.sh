
# `job PART` renders a part, `job task TRIES` that of a task of a Slurm array, and `job merge` merges the parts: of the
# picture that is described above.
part=$1
[[ $part != task ]] || part=$SLURM_ARRAY_TASK_ID
cd "$from" || exit 3

if [[ $part == merge ]]; then
  exec "$image" merge "$folder"/part-*[0-9].exr -o "$output"
fi

first=$((samples * part / parts)) end=$((samples * (part + 1) / parts))
file=$folder/part-$first-$end.exr
log=$file.log

# What a disk has damaged is rendered again; a part that was stopped is gone on with.
for old in "$file" "$file.checkpoint.exr"; do
  if [[ -e $old ]]; then
    "$image" info "$old" >/dev/null 2>&1
    (($? != 3)) || rm -f -- "$old"
  fi
done

# A job that is told to stop has its render write a checkpoint.
{
  echo "part $part on $HOSTNAME, process $BASHPID"
  exec "${render[@]}" --samples "$first:$end" -o "$file" --resume --progress lines
} >>"$log" 2>&1 &
process=$!
trap 'kill -TERM "$process" 2>/dev/null' TERM INT HUP
while wait "$process"; code=$?; kill -0 "$process" 2>/dev/null; do :; done

echo "exit $code" >>"$log"
echo "part $part of $parts: exit $code on $HOSTNAME, log $log"
# Slurm restarts jobs of nodes that fail, and this those of renders that fail: not of bad usage or input, nor when told
# to stop.
if [[ $1 == task && ! $code =~ ^(0|2|3|130)$ ]] && ((${SLURM_RESTART_COUNT:-0} + 1 < $2)); then
  scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
fi
exit "$code"
