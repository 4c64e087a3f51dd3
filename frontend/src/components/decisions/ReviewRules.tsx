import { Button, Group, Switch, Text, TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { useAnalyst } from "../../api/analyst";
import { useChangeRules } from "../../api/commands";
import { reviewRulesQuery } from "../../api/queries";
import { useMay } from "../../api/roles";
import type { RulesHistory } from "../../api/types";
import { dateTime } from "../../lib/text/format";
import { Loaded } from "../display/Loaded";
import { NumberField } from "../controls/NumberField";
import { ProblemAlert } from "../display/ProblemAlert";

/** Review rules of a campaign; a change is stored with author and reason. */
export function ReviewRules({ aircraftId }: { aircraftId: number }) {
  const rules = useQuery(reviewRulesQuery(aircraftId));
  return (
    <Loaded query={rules} rows={2}>
      {(history) => (
        <Rules
          key={`${aircraftId} ${history.current.version}`}
          aircraftId={aircraftId}
          history={history}
        />
      )}
    </Loaded>
  );
}

function Rules({ aircraftId, history }: { aircraftId: number; history: RulesHistory }) {
  const { current, items } = history;
  const name = useAnalyst();
  const mayChange = useMay("admin", aircraftId);
  const change = useChangeRules(aircraftId);
  const [quorum, setQuorum] = useState(current.quorum);
  const [own, setOwn] = useState(current.own_allowed);
  const [reason, setReason] = useState("");
  const changed = quorum !== current.quorum || own !== current.own_allowed;
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        change.mutate({ quorum, own_allowed: own, version: current.version, reason });
      }}
    >
      <Group align="end" gap="md">
        <NumberField
          label="Quorum"
          w={90}
          hideControls={false}
          disabled={!mayChange}
          min={1}
          max={50}
          allowDecimal={false}
          value={quorum}
          onChange={(value) => {
            if (value !== undefined) setQuorum(value);
          }}
        />
        <Switch
          label="Allow votes on own proposals"
          checked={own}
          disabled={!mayChange}
          onChange={(event) => {
            setOwn(event.currentTarget.checked);
          }}
        />
        {changed && (
          <>
            <TextInput
              label="Reason"
              style={{ flex: 1, minWidth: 160 }}
              value={reason}
              onChange={(event) => {
                setReason(event.currentTarget.value);
              }}
            />
            <Button
              type="submit"
              disabled={reason.trim() === "" || name === ""}
              loading={change.isPending}
            >
              {name === "" ? "Set your name first" : "Change the rules"}
            </Button>
          </>
        )}
      </Group>
      {change.isError && <ProblemAlert error={change.error} />}
      {items.map((one) => (
        <Text key={one.version} size="xs" className="quiet" mt={4}>
          {dateTime(one.created_at)} {one.author}: quorum {one.quorum},{" "}
          {one.own_allowed ? "own proposals allowed" : "own proposals excluded"} ({one.reason})
        </Text>
      ))}
    </form>
  );
}
