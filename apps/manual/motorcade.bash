# Completes words behind `motorcade` in bash: commands, options and the values that an option allows. All are read from the program's
# own help; any other word is completed as the name of a file.

# Reads the help of the program; names of its commands.
_motorcade_commands() { sed -n '/^Subcommands:/,$ s/^  \([a-z]\{1,\}\) .*/\1/p'; }

# Reads a command's help; names of its options.
_motorcade_options() { sed -n 's/^  \(-[^ ]*\).*/\1/p' | tr ',' '\n'; }

# Reads a command's help; the values of option $1, which it gives as `--scene TEXT:{overtake,highway}`.
_motorcade_values() {
  grep -E -- "^  (-[a-z],)?$1 " | sed -n 's/^[^{]*{\([^}]*\)}.*/\1/p' | tr ',' '\n'
}

_motorcade() {
  local program=$1 word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command='' help choices=''
  # bash takes `--scene=over` apart into three words
  [[ $word == '=' ]] && word='' && before="$before="
  [[ $before == '=' ]] && before=${COMP_WORDS[COMP_CWORD - 2]}
  before=${before%=}
  help=$("$program" --help 2>/dev/null) || return
  local commands each
  commands=$(_motorcade_commands <<<"$help")
  for each in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    [[ -z $command && $'\n'$commands$'\n' == *$'\n'"$each"$'\n'* ]] && command=$each
  done
  [[ -n $command ]] && help=$("$program" "$command" --help 2>/dev/null)

  if [[ $before == -* ]]; then choices=$(_motorcade_values "$before" <<<"$help"); fi
  if [[ -z $choices ]]; then
    case $word in
      -*) choices=$(_motorcade_options <<<"$help") ;;
      *) if [[ -z $command || $command == help ]]; then choices=$commands; else choices=$(_motorcade_commands <<<"$help"); fi ;;
    esac
  fi
  mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$word")
}

complete -o default -F _motorcade motorcade
