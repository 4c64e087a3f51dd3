import { Group, Loader, Text } from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import { healthQuery } from "../../api/queries";
import { renew } from "../../api/renew";

/** Progress of the demonstration campaign while the server adds its maneuvers. */
export function CampaignProgress() {
  const cache = useQueryClient();
  const { data } = useQuery(healthQuery);
  const part = data?.parts.find(
    ({ name, state }) => name === "demonstration" && state === "starting",
  );
  const text = part?.text;
  useEffect(() => {
    if (text === undefined) return;
    // With every further maneuver the text changes; after the last one it is gone.
    return () => {
      for (const key of ["maneuvers", "flights", "aircraft", "ground-tests"]) {
        void renew(cache, { queryKey: [key] });
      }
    };
  }, [cache, text]);
  if (text === undefined) return null;
  return (
    <Group
      className="panel"
      role="status"
      p="sm"
      mb="md"
      gap="sm"
      wrap="nowrap"
      data-testid="campaign-progress"
    >
      <Loader size="xs" aria-hidden="true" />
      <Text size="sm">{text} Maneuvers can be used as soon as they are listed.</Text>
    </Group>
  );
}
