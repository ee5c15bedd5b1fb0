// cotree completion: scripts that complete command lines, from the tables of commands and options.
//
// Each script completes the command first, then the options of that command; after an option
// its words, or files where its value is one.
#include "cli/cli.h"

#include <string.h>

static bool is_file(const struct cli_option *o)
{
    return o->value && (strstr(o->value, "FILE") || (o->words && strstr(o->help, "FILE")));
}

// Does the command use the option?
static bool is_offered(const struct cli_option *o, const struct cli_command *c)
{
    return o->use & c->use;
}

// Prints text for single quotes, with `quoted` for a quote in it; line breaks become blanks.
static void print_quoted(FILE *out, const char *text, const char *quoted)
{
    for (; *text; text++)
        if (*text == '\'')
            fputs(quoted, out);
        else
            fputc(*text == '\n' ? ' ' : *text, out);
}

// ---- bash ----------------------------------------------------------------------------------

static void print_bash_command(FILE *out, const struct cli_command *c)
{
    fprintf(out, "  %s)\n    case $previous in\n", c->name);
    for (size_t i = 0; i < cli_noption; i++) {
        const struct cli_option *o = &cli_options[i];
        if (!o->value || !is_offered(o, c))
            continue;
        fprintf(out, "    --%s", o->name);
        if (o->letter)
            fprintf(out, " | -%c", o->letter);
        fprintf(out, ") words='%s'; files=%d ;;\n", o->words ? o->words : "", is_file(o));
    }
    fputs("    *)\n      words='", out);
    for (const char *const *w = c->words; w && *w; w++)
        fprintf(out, "%s ", *w);
    for (size_t i = 0; i < cli_noption; i++)
        if (is_offered(&cli_options[i], c))
            fprintf(out, "--%s ", cli_options[i].name);
    fprintf(out, "'\n      files=%d ;;\n    esac ;;\n",
            c->takes_model || c->takes_file || c->files);
}

static void print_bash(FILE *out)
{
    fputs("# Completion of cotree for bash, made by 'cotree completion bash'.\n"
          "_cotree() {\n"
          "  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}\n"
          "  local command='' words='' files=0 i\n"
          "  COMPREPLY=()\n"
          "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
          "    case ${COMP_WORDS[i]} in\n"
          "    -*) ;;\n"
          "    help) command=help ;;\n"
          "    *) command=${COMP_WORDS[i]}; break ;;\n"
          "    esac\n"
          "  done\n"
          "  [ \"$command\" = help ] && command=''\n"
          "  case $command in\n"
          "  '') words='",
          out);
    for (const struct cli_command *const *c = cli_commands; *c; c++)
        fprintf(out, "%s ", (*c)->name);
    fputs("help --help --version' ;;\n", out);
    for (const struct cli_command *const *c = cli_commands; *c; c++)
        print_bash_command(out, *c);
    fputs("  esac\n"
          "  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\")\n"
          "  if [ \"$files\" = 1 ] && [ \"${#COMPREPLY[@]}\" = 0 ]; then\n"
          "    mapfile -t COMPREPLY < <(compgen -f -- \"$current\")\n"
          "    compopt -o filenames 2>/dev/null\n"
          "  fi\n"
          "}\n"
          "complete -F _cotree cotree\n",
          out);
}

// ---- zsh -----------------------------------------------------------------------------------

// Text of a specification for _arguments, in single quotes; escapes ':', '[' and ']'.
static void print_zsh_text(FILE *out, const char *text)
{
    for (; *text; text++) {
        if (strchr(":[]\\", *text))
            fputc('\\', out);
        print_quoted(out, (char[]){*text, 0}, "'\\''");
    }
}

static void print_zsh_option(FILE *out, const struct cli_option *o)
{
    const bool repeats = o->kind == CLI_LIST;
    fprintf(out, "      '%s", repeats ? "*" : "");
    if (o->letter)
        fprintf(out, "(-%c --%s)'{-%c,--%s}'", o->letter, o->name, o->letter, o->name);
    else
        fprintf(out, "--%s", o->name);
    fputc('[', out);
    print_zsh_text(out, o->help);
    fputc(']', out);
    if (o->value) {
        fputc(':', out);
        print_zsh_text(out, o->value);
        fputc(':', out);
        if (o->words && is_file(o))
            fprintf(out, "{compadd %s; _files}", o->words);
        else if (o->words)
            fprintf(out, "(%s)", o->words);
        else if (is_file(o))
            fputs("_files", out);
    }
    fputs("' \\\n", out);
}

static void print_zsh_command(FILE *out, const struct cli_command *c)
{
    fprintf(out, "    %s)\n      _arguments -s \\\n", c->name);
    for (size_t i = 0; i < cli_noption; i++)
        if (is_offered(&cli_options[i], c))
            print_zsh_option(out, &cli_options[i]);
    if (c->words) {
        fputs("      '1:word:(", out);
        for (const char *const *w = c->words; *w; w++)
            fprintf(out, "%s%s", w == c->words ? "" : " ", *w);
        fputs(")'", out);
    } else {
        fprintf(out, "      %s",
                c->takes_model  ? "'1:model:_files -g \"*.(yaml|yml)\"'"
                : c->takes_file ? "'1:file:_files'"
                : c->files      ? "'*:file:_files -g \"*.csv\"'"
                                : "");
    }
    fputs(" ;;\n", out);
}

static void print_zsh(FILE *out)
{
    fputs("#compdef cotree\n"
          "# Completion of cotree for zsh, made by 'cotree completion zsh'.\n"
          "_cotree() {\n"
          "  local -a commands\n"
          "  commands=(\n",
          out);
    for (const struct cli_command *const *c = cli_commands; *c; c++) {
        fprintf(out, "    '%s:", (*c)->name);
        print_quoted(out, (*c)->summary, "'\\''");
        fputs("'\n", out);
    }
    fputs("    'help:the options of a command'\n"
          "  )\n"
          "  if ((CURRENT == 2)) || { ((CURRENT == 3)) && [[ ${words[2]} == help ]]; }; then\n"
          "    _describe command commands\n"
          "    return\n"
          "  fi\n"
          "  local command=${words[2]}\n"
          "  shift words\n"
          "  ((CURRENT--))\n"
          "  case $command in\n",
          out);
    for (const struct cli_command *const *c = cli_commands; *c; c++)
        print_zsh_command(out, *c);
    fputs("  esac\n"
          "}\n"
          "if [[ ${funcstack[1]} == _cotree ]]; then\n" // autoloaded from a folder of fpath
          "  _cotree \"$@\"\n"
          "else\n"
          "  compdef _cotree cotree\n"
          "fi\n",
          out);
}

// ---- fish ----------------------------------------------------------------------------------

static void print_fish_text(FILE *out, const char *text)
{
    fputs(" -d '", out);
    print_quoted(out, text, "\\'");
    fputs("'\n", out);
}

static void print_fish_option(FILE *out, const struct cli_command *c,
                              const struct cli_option *o)
{
    fprintf(out, "complete -c cotree -n '__fish_seen_subcommand_from %s' -l %s", c->name,
            o->name);
    if (o->letter)
        fprintf(out, " -s %c", o->letter);
    if (o->value)
        fputs(is_file(o) ? " -r -F" : " -x", out);
    if (o->words)
        fprintf(out, " -a '%s'", o->words);
    print_fish_text(out, o->help);
}

static void print_fish(FILE *out)
{
    fputs("# Completion of cotree for fish, made by 'cotree completion fish'.\n"
          "complete -c cotree -f\n"
          "complete -c cotree -n __fish_use_subcommand -a help -d 'the options of a command'\n",
          out);
    for (const struct cli_command *const *c = cli_commands; *c; c++) {
        fprintf(out,
                "complete -c cotree -n '__fish_use_subcommand; or __fish_seen_subcommand_from "
                "help' -a %s",
                (*c)->name);
        print_fish_text(out, (*c)->summary);
        if ((*c)->takes_model || (*c)->files)
            fprintf(out, "complete -c cotree -n '__fish_seen_subcommand_from %s' -F\n",
                    (*c)->name);
        for (const char *const *w = (*c)->words; w && *w; w++)
            fprintf(out, "complete -c cotree -n '__fish_seen_subcommand_from %s' -a %s\n",
                    (*c)->name, *w);
        for (size_t i = 0; i < cli_noption; i++)
            if (is_offered(&cli_options[i], *c))
                print_fish_option(out, *c, &cli_options[i]);
    }
}

// --------------------------------------------------------------------------------------------

static const char *const shells[] = {"bash", "zsh", "fish", NULL};

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    static void (*const print[])(FILE * out) = {print_bash, print_zsh, print_fish};
    size_t i = 0;
    while (strcmp(shells[i], args->word) != 0)
        i++;
    struct ct_output *o = ct_output_open(ctx, args->output);
    if (!o)
        return CLI_FAILED;
    print[i](ct_output_stream(o));
    return ct_output_close(ctx, o, true) ? CLI_DONE : CLI_FAILED;
}

const struct cli_command cli_completion = {
    .name = "completion",
    .summary = "prints a script that completes command lines in bash, zsh or fish",
    .use = CLI_COMPLETION,
    .words = shells,
    .more = "\n"
            "Installing cotree puts the scripts where the shells look for them. Without that:\n"
            "\n"
            "  bash   source <(cotree completion bash)      in ~/.bashrc\n"
            "  zsh    source <(cotree completion zsh)       in ~/.zshrc, after compinit\n"
            "  fish   cotree completion fish | source       in ~/.config/fish/config.fish\n",
    .examples = {"cotree completion bash", "cotree completion zsh -o _cotree"},
    .run = run,
};
