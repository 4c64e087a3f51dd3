import { Button, Group, Text } from "@mantine/core";
import { useCorrectCause } from "../../api/commands";
import type { Run } from "../../api/types";
import { TAKE } from "../quality/corrections";
import { ProblemAlert } from "../display/ProblemAlert";

/** Takes the corrections of the causes that a rejected run names. */
export function NamedCorrections({ run }: { run: Run }) {
  const take = useCorrectCause(run);
  const offers = (run.adequacy?.causes ?? []).flatMap(({ finding }) => finding.correction ?? []);
  if (offers.length === 0) return null;
  const what = offers.map((one) => `${TAKE[one.kind].toLowerCase()} ${one.channel}`).join(", ");
  return (
    <Group gap="xs" mt="xs">
      <Button
        size="xs"
        variant="default"
        loading={take.isPending}
        disabled={take.isSuccess}
        title="For all maneuvers of the aircraft that have the channel; recorded data are not changed, and the correction can be undone"
        data-testid="correct-cause"
        onClick={() => {
          take.mutate();
        }}
      >
        {what.charAt(0).toUpperCase() + what.slice(1)}
      </Button>
      {take.isSuccess && <Text size="sm">Corrected: estimate again.</Text>}
      {take.isError && <ProblemAlert error={take.error} />}
    </Group>
  );
}
