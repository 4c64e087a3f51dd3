import { Alert, Button, Group, NumberInput, Stack, Text } from "@mantine/core";
import type { Guess } from "../../api/types";
import { confirmPath, setKey } from "../../lib/text/mappingText";

interface Props {
  guesses: Guess[];
  text: string;
  onChange: (text: string) => void;
}

const TITLES: Record<Guess["kind"], string> = {
  aircraft: "Aircraft",
  flight: "Flight",
  clock: "Clock",
  unit: "Units",
  role: "Roles",
  name: "Names",
  condition: "Flight condition",
};

/** Assumptions of the mapping and their consequences; the import requires their confirmation. */
export function MappingGuesses({ guesses, text, onChange }: Props) {
  const kinds = [...new Set(guesses.map((guess) => guess.kind))];
  return (
    <Alert
      color="yellow"
      variant="light"
      title="Assumptions to confirm before the import"
      data-testid="mapping-guesses"
    >
      <Stack gap="sm">
        <Group justify="space-between" align="start" wrap="nowrap">
          <Text size="sm">
            A correction in the table confirms its key; confirm the other assumptions by kind, or
            all at once.
          </Text>
          <Button
            size="xs"
            variant="default"
            flex="none"
            onClick={() => {
              onChange(guesses.reduce((changed, guess) => confirmPath(changed, guess.key), text));
            }}
          >
            Confirm all {guesses.length}
          </Button>
        </Group>
        {kinds.map((kind) => {
          const own = guesses.filter((guess) => guess.kind === kind);
          const rate = own.find((guess) => guess.key === "time.rate");
          return (
            <Group key={kind} justify="space-between" align="start" wrap="nowrap">
              <div>
                <Text size="sm" fw={600}>
                  {TITLES[kind]}
                </Text>
                {own.map((guess) => (
                  <Text key={guess.key} size="sm">
                    {named(guess.key, text)} <b>{guess.value}</b>: {guess.consequence}
                    {isRemembered(guess.key, text) && " Remembered from an earlier import."}
                  </Text>
                ))}
                {rate !== undefined && (
                  <NumberInput
                    size="xs"
                    w={140}
                    label="Sampling rate [Hz]"
                    min={0}
                    hideControls
                    value={Number.parseFloat(rate.value)}
                    onBlur={(event) => {
                      const value = Number(event.currentTarget.value);
                      if (value > 0) onChange(withRate(text, value));
                    }}
                  />
                )}
              </div>
              <Button
                size="xs"
                variant="default"
                flex="none"
                aria-label={`Confirm: ${TITLES[kind]}`}
                onClick={() => {
                  onChange(own.reduce((changed, guess) => confirmPath(changed, guess.key), text));
                }}
              >
                Confirm
              </Button>
            </Group>
          );
        })}
      </Stack>
    </Alert>
  );
}

/** A key as the table above names it: the channel instead of its number. */
function named(key: string, text: string): string {
  const [, number, part] = /^channels\[(\d+)\]\.(\w+)$/.exec(key) ?? [];
  if (number === undefined) return key;
  const own = text.split(/^\[\[channels\]\].*$/m)[Number(number)] ?? "";
  const name = /^name\s*=\s*"([^"]*)"/m.exec(own) ?? /^column\s*=\s*"([^"]*)"/m.exec(own);
  return `${name?.[1] ?? key}, ${part}`;
}

/** Whether the channel of a key was mapped so in an earlier import. */
function isRemembered(key: string, text: string): boolean {
  const [, number] = /^channels\[(\d+)\]\./.exec(key) ?? [];
  if (number === undefined) return false;
  const own = text.split(/^\[\[channels\]\].*$/m)[Number(number)] ?? "";
  return own.includes("# remembered from an earlier import");
}

function withRate(text: string, rate: number): string {
  const stated = setKey(text, "time", 0, "rate", "?");
  return stated.replace('rate = "?"', `rate = { value = ${rate}, unit = "Hz" }`);
}
