// A Slurm of two nodes on this machine, without systemd, cgroups or root: everything in one temporary folder, on ports
// of its own, and gone with the test, however that ends (the daemons are told to end when their parent dies).
#pragma once

#include "pipeline/process.h"
#include "support/command.h"
#include "support/temporary_folder.h"

#include <arpa/inet.h>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <netinet/in.h>
#include <random>
#include <string>
#include <sys/socket.h>
#include <unistd.h>
#include <vector>

namespace quoin::test {

class LocalSlurm {
public:
    // Why it cannot be started here, or "".
    static std::string missing()
    {
        for (const char* program : {"munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol"})
            if (run_command(tools() + "command -v " + program).exit_code != 0)
                return std::string(program) + " is not installed (packages slurm-wlm and munge)";
        return "";
    }

    // Begins a shell command line: Slurm's tools are in $PATH.
    static std::string tools() { return "export PATH=$PATH:/usr/sbin:/sbin; "; }

    LocalSlurm()
    {
        for (const char* folder : {"munge", "ctld", "log"})
            std::filesystem::create_directory(folder_ / folder);
        write_key();
        std::ofstream(folder_ / "slurm.conf") << configuration();
        const std::string munge = path("munge/munge");
        start("munged -F --force --key-file=" + munge + ".key --socket=" + munge + ".socket --pid-file=" + munge +
              ".pid --seed-file=" + munge + ".seed --num-threads=2");
        is_up_ = wait_until([&] { return std::filesystem::exists(munge + ".socket"); });
        start("slurmctld -D -f " + path("slurm.conf"));
        is_up_ = is_up_ && wait_until([&] { return call("scontrol ping").find("is UP") != std::string::npos; });
        for (const char* node : {"n1", "n2"})
            start("slurmd -D -f " + path("slurm.conf") + " -N " + node);
        is_up_ = is_up_ && wait_until([&] { return call("sinfo -h -N -o %t") == "idle\nidle\n"; });
    }

    ~LocalSlurm()
    {
        call("scancel --user=$(id -un)");
        wait_until([&] { return call("squeue -h -t R,CG").empty(); });
        for (auto daemon = daemons_.rbegin(); daemon != daemons_.rend(); ++daemon) {
            (*daemon)->signal_group(SIGTERM);
            wait_until([&] { return (*daemon)->poll_end().has_value(); });
            daemon->reset();
        }
    }

    bool is_up() const { return is_up_; }
    std::string environment() const { return tools() + "export SLURM_CONF=" + path("slurm.conf") + "; "; }
    std::string call(const std::string& command) const { return run_command(environment() + command).output; }
    std::string log() const { return call("tail -n 20 " + path("log") + "/*"); }

    // Until no job waits or runs; false after two minutes.
    bool wait_for_jobs() const
    {
        return wait_until([&] { return call("squeue -h -t PD,R,CG,CF").empty(); });
    }

    static bool wait_until(const std::function<bool()>& is_so)
    {
        constexpr int kTries = 600;
        for (int i = 0; i < kTries; ++i, ::usleep(200'000))
            if (is_so()) return true;
        return false;
    }

private:
    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    void start(const std::string& command)
    {
        const std::string name = command.substr(0, command.find(' '));
        daemons_.push_back(std::make_unique<ChildProcess>(
            "/bin/sh",
            std::vector<std::string>{"-c", tools() + "exec " + command + " >>" + path("log/" + name) + " 2>&1"},
            Streams::Merged));
    }

    void write_key() const
    {
        std::random_device random;
        std::ofstream key(folder_ / "munge" / "munge.key", std::ios::binary);
        for (int i = 0; i < 1024; ++i)
            key.put(static_cast<char>(random()));
        key.close();
        std::filesystem::permissions(folder_ / "munge" / "munge.key", std::filesystem::perms::owner_read);
        std::filesystem::permissions(folder_ / "munge", std::filesystem::perms(0711));
    }

    // A port that is free now.
    static int free_port()
    {
        const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof(address);
        const bool is_bound = ::bind(socket, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
                              ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) == 0;
        ::close(socket);
        return is_bound ? ntohs(address.sin_port) : 0;
    }

    std::string configuration() const
    {
        std::string host = run_command("hostname -s").output;
        host.erase(host.find_last_not_of('\n') + 1);
        std::string user = run_command("id -un").output;
        user.erase(user.find_last_not_of('\n') + 1);
        std::string nodes;
        for (const char* node : {"n1", "n2"})
            nodes += std::string("NodeName=") + node + " NodeHostname=" + host +
                     " NodeAddr=127.0.0.1 Port=" + std::to_string(free_port()) +
                     " CPUs=4 Boards=1 SocketsPerBoard=1 CoresPerSocket=4 ThreadsPerCore=1 RealMemory=4000\n";
        return "ClusterName=local\nSlurmctldHost=" + host + "(127.0.0.1)\nSlurmUser=" + user + "\nSlurmdUser=" + user +
               "\nAuthType=auth/munge\nCredType=cred/munge\nAuthInfo=socket=" + path("munge/munge.socket") +
               ",cred_expire=10\nSlurmctldPort=" + std::to_string(free_port()) +
               "\nCommunicationParameters=NoCtldInAddrAny,NoInAddrAny\nStateSaveLocation=" + path("ctld") +
               "\nSlurmdSpoolDir=" + path("spool-%n") + "\nSlurmctldPidFile=" + path("ctld.pid") +
               "\nSlurmdPidFile=" + path("slurmd-%n.pid") +
               "\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nJobAcctGatherType=jobacct_gather/none\n"
               "AccountingStorageType=accounting_storage/none\nSchedulerType=sched/backfill\n"
               "SchedulerParameters=sched_interval=1,batch_sched_delay=0,sched_min_interval=0,bf_interval=1\n"
               "SelectType=select/cons_tres\nSelectTypeParameters=CR_Core_Memory\nSlurmdParameters=config_overrides\n"
               "EnforcePartLimits=ALL\nReturnToService=2\nMpiDefault=none\nKillWait=5\nMinJobAge=3600\n"
               "MaxArraySize=1001\nDefMemPerCPU=100\n" +
               nodes + "PartitionName=main Nodes=ALL Default=YES MaxTime=24:00:00 State=UP\n";
    }

    TemporaryFolder folder_;
    std::vector<std::unique_ptr<ChildProcess>> daemons_;
    bool is_up_ = false;
};

} // namespace quoin::test
