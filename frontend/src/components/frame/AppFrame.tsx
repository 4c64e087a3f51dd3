import { AppShell, Group } from "@mantine/core";
import { Link, Outlet } from "@tanstack/react-router";
import { useServerEvents } from "../../api/serverEvents";
import { AnalystMenu } from "../account/AnalystMenu";
import { ColorSchemeToggle } from "./ColorSchemeToggle";
import { Degraded, Health, LostConnection } from "./Health";
import { Keyboard } from "./Keyboard";
import { MainNav, SideNav } from "./MainNav";
import { NoticeBar } from "./NoticeBar";
import { Notifications } from "./Notifications";
import { Tour } from "./Tour";
import { UnitMenu } from "./UnitMenu";

/** Header with navigation around every page. */
export function AppFrame() {
  useServerEvents();
  return (
    <AppShell header={{ height: 48 }}>
      <a className="skip" href="#content">
        Skip to content
      </a>
      <AppShell.Header>
        <div className="frame-header">
          <Link to="/" className="frame-name" aria-label="flexsid, start page">
            flexsid
          </Link>
          <MainNav />
          <Group ml="auto" className="frame-side" wrap="nowrap">
            <SideNav />
            <Keyboard />
            <Notifications />
            <UnitMenu />
            <AnalystMenu />
            <Health />
            <ColorSchemeToggle />
          </Group>
        </div>
      </AppShell.Header>
      <AppShell.Main>
        <div className="page" id="content" tabIndex={-1}>
          <LostConnection />
          <Degraded />
          <Tour />
          <Outlet />
        </div>
      </AppShell.Main>
      <NoticeBar />
    </AppShell>
  );
}
