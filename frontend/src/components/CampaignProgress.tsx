import { Group, Loader, Text } from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import { healthQuery } from "../api/queries";

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
    const renew = () => {
      for (const key of ["health", "maneuvers", "flights", "aircraft", "ground-tests"]) {
        void cache.invalidateQueries({ queryKey: [key] });
      }
    };
    const timer = window.setInterval(renew, 1500);
    return () => {
      window.clearInterval(timer);
      renew(); // the last maneuvers, when the part has ended
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
