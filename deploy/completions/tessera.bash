# Completion for bash of tessera, tessera-master, tessera-node and tessera-display: commands, options, and values of
# options with fixed choices, all from --help. Put into ~/.bashrc:  source deploy/completions/tessera.bash
_tessera() {
    local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} i help line
    local command=("${COMP_WORDS[0]}")
    for ((i = 1; i < COMP_CWORD; ++i)); do
        [[ ${COMP_WORDS[i]} != -* ]] || break
        help=$("${command[@]}" --help 2>/dev/null) || return
        grep -qE "^  ${COMP_WORDS[i]} " <<<"${help#*Subcommands:}" || break
        command+=("${COMP_WORDS[i]}")
    done
    help=$("${command[@]}" --help 2>/dev/null) || return
    if [[ $previous == --* ]]; then
        line=$(grep -E "^  .*$previous " <<<"$help" | grep -oE '[a-z0-9-]+(\|[a-z0-9-]+)+' | head -n 1)
        if [ -n "$line" ]; then
            mapfile -t COMPREPLY < <(compgen -W "${line//|/ }" -- "$word")
            return
        fi
    fi
    if [[ $word == -* ]]; then
        line=$(sed -n '/^Options:/,/^$/p' <<<"$help" | grep -oE '^  (-[a-zA-Z],)?--[a-z][a-z-]*' | grep -oE -- '--.*')
        mapfile -t COMPREPLY < <(compgen -W "$line" -- "$word")
    elif [[ $help == *Subcommands:* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$(sed -n '/^Subcommands:/,/^$/p' <<<"$help" | grep -oE '^  [a-z][a-z-]*')" -- "$word")
    fi
}
complete -o default -F _tessera tessera tessera-master tessera-node tessera-display
